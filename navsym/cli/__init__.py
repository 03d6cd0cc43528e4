"""The command line: one file for each verb, which reads, calls and prints."""

"""The languages of exported code, and what they share."""

"""Gaussian mixtures and banks of filters in compiled loops."""

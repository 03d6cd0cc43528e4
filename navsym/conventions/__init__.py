"""Conventions of an error model: cards, the error dynamics derived from a card, and the cards under which a model is right."""

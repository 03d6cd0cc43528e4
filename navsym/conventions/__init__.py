"""Conventions of an error model: cards, the dynamics derived from a card, the cards under which a model is right."""

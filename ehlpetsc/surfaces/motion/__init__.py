"""Surfaces and depth fields that move with the bodies."""

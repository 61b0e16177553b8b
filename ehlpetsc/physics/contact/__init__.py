"""Dry contact: geometry and nodes of each kind, Hertz, contact of roughness."""

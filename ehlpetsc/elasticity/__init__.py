"""Elasticity: moduli of both bodies, deflection of a mesh by the pressure of one of its cells."""

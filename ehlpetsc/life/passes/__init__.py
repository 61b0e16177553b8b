"""Solved passes: one, those of a round on all ranks, and the positions of surface 2 in them."""

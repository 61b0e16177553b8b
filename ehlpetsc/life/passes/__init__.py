"""Solved passes: a single pass, the passes of a round on all ranks, the positions of surface 2."""

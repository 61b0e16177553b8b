"""Bodies over a life: their cells and columns, what wear and damage do to them, and how far a jump goes."""

"""Studies of the solver itself: its table of extremes, its error against run time, random cases."""

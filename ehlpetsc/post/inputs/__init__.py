"""Reading and checks of the loads and the case of a result file."""

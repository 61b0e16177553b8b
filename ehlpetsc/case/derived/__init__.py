"""Values of a case that follow from others: steels, oil grades, layers of profiles, conditions over time."""

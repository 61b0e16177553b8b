"""Heat: the law of the film, conduction into both bodies, transport along the film, the effect."""

"""Figures of several results: over the speed, the slide/roll ratio, seeds, passes."""

"""Bodies over a life: cells and columns, wear, damage and break-outs, length of a jump."""

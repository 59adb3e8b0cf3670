"""What a recording says at each sample, and what in it is of the sensors."""

"""What an effect is, and how it is put into a diagram: in a signal's path, as a factor, as a lag."""

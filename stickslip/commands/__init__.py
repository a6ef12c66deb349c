"""The commands, one a file, loaded when called."""

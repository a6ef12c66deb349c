"""Files of records: what historians and control systems write, read; what is read and simulated, written."""

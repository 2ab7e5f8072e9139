"""What the instruments of a case write: noise, faults and lost rows."""

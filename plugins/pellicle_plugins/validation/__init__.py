"""What results of runs are compared with."""

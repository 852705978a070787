"""What people read of a compile: the texts of its stages."""

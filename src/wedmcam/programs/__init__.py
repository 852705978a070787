"""What can be asked of a program, whoever made it: places, and which block is which."""

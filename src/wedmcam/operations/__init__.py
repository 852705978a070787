"""What a command does, one module each: it calls the compiler and returns values."""

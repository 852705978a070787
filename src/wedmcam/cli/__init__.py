"""The command line: the shell that opens, prints and exits. Everything else is in the library."""

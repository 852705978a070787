"""The compiler: `pipeline` is the whole of it on one screen."""

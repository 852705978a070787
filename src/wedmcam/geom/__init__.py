"""Float kernels: arrays in, arrays out, micrometres. No spans, no findings, no policy."""

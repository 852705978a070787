"""What the commands do, a file each, loaded when one runs.

Help and settings ask for options alone, so they load no reader, compiler or judge.
"""

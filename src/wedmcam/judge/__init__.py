"""The judge: it decodes what was written, runs it, and compares it with the plan and the part.

It shares no geometry with what made the program, and is tested with forgeries that it must refuse.
Importing this costs nothing: `judge.judge` judges, `judge.fit` finds where a program of unknown
origin lies, `judge.certificate` writes down what was found.
"""

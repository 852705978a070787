"""The shape of what is read and written: fields, codes, limits and rules of each format.

Readers and writers share these modules and nothing else, so that a rule stands in one place. They
are pure arithmetic on arrays: no text of messages, no files.
"""

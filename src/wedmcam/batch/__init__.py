"""Many drawings to programs: which ones, one of them as a task, and the processes that do them.

`items` finds the drawings and says where their programs go, `work` compiles one of them and returns
what came of it as data, `pool` does that in several processes. Nothing here knows a terminal: an
outcome holds findings as values, so that a shell, a web page or another machine can show them.
"""

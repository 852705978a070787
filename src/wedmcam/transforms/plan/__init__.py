"""From what is asked of each cut to the plan: where the wire goes, in which order.

A drawing is a part program of one cut. Its stages, each a module: what is asked (`shaped`), the
contours with their sides (`pieces`), which of them make one part (`scenes`), the wire paths
(`paths`), thread points and leads (`leads`), the order (`order`), the cuts (`cuts`); `planner` runs
them. `portion` takes part of a plan. Nothing is imported here: who reads needs no wire paths.
"""

"""Windows that change over the year: laws that choose a state for every group of windows at every step.

A law is a function of series (steps) that knows neither rooms nor files; states are numbered from the most open one,
0. What laws need to know of a room is found in `signals`.
"""

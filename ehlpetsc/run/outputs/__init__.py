"""Outputs of a run: observers that receive every accepted state, on every rank.

An output has two methods: ``write(state)`` for a `run.accepted_state.AcceptedState` and ``close(status)``
for the `errors.ExitStatus` of the run.
"""

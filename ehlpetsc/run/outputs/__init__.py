"""Outputs of a run: observers that receive every accepted state, on every rank.

An output has two methods: ``take(state)`` for a `run.accepted_state.AcceptedState`, ``close(status)`` for the
`errors.ExitStatus` of the run.
"""

"""A pendulum of two links that swings freely, for as long as it can be foretold."""

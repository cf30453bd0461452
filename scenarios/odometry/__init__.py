"""A wheeled robot whose wheels are driven at given rates: where does dead reckoning put it?"""

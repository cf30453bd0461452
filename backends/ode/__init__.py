"""ODE, the Open Dynamics Engine: bodies of their own, bound by joints and contacts."""

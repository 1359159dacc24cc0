"""Many runs of the bench: designs of experiments, on all processors or a cluster, resumable."""

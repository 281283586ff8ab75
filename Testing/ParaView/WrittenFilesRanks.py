# SPDX-License-Identifier: BSD-3-Clause
"""Under pvbatch --sym an error that one rank alone has is raised on all, which then go on together."""
import lacuna_test


def on_each_rank():
    """The error of a writer, which the first rank has alone, is that of all, which then go on together."""
    from lacuna.errors import PipelineError, raising
    import lacuna.plugin
    import paraview.simple as pv
    lacuna.plugin.load()
    from paraview.modules.vtkRemotingCore import vtkProcessModule
    rank = vtkProcessModule.GetProcessModule().GetPartitionId()
    sweep = pv.PhantomSweep(NumberOfSlices=5)
    for name in ("/no/such/folder/x.mha", "/no/such/folder/x.stl"):
        source = sweep if name.endswith("mha") else pv.Sphere()
        try:
            with raising():
                pv.SaveData(name, source)
            raise AssertionError(f"rank {rank} knows of no error")
        except PipelineError as error:
            assert "x." in str(error), error
    try:
        with raising():
            if rank == 1:
                raise KeyError("of the second rank")
        raise AssertionError(f"rank {rank} knows of no error")
    except (PipelineError, KeyError) as error:
        assert isinstance(error, KeyError) == (rank == 1) and "of the second rank" in str(error), error
    with raising():
        pv.SpeckleFilter(Input=sweep).UpdatePipeline()


lacuna_test.on_two_ranks(__file__, on_each_rank)

// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What is told of failures, and when.
#ifndef vtkLacunaFailure_h
#define vtkLacunaFailure_h

#include <string>

class vtkAlgorithm;
class vtkInformationVector;

/// Of empty data VTK takes for up to date nobody would hear any more, and writers would put nothing in the
/// place of good files: so an algorithm fails for each who asks, until something is changed. ParaView asks
/// several times for one command: within seconds the same error is shown once, and the same work not done
/// again.
namespace vtkLacunaFailure
{
/// Keeps the error of RequestInformation for who asks for data; empty: there is none.
void Announce(vtkAlgorithm* algorithm, const std::string& error);

/// The error that was announced; empty: none.
std::string GetAnnounced(vtkAlgorithm* algorithm);

/// The error with which the same request for the same inputs has failed a moment ago; empty: none.
std::string GetRecent(vtkAlgorithm* algorithm, vtkInformationVector* outputs);

/// Makes error one of algorithm. Its outputs are marked as not generated.
void Tell(vtkAlgorithm* algorithm, vtkInformationVector* outputs, const std::string& error);
}
#endif

// SPDX-License-Identifier: BSD-3-Clause
// lacuna-step: the process in which lacuna::MakeStep has OpenCASCADE make a STEP file of a solid with flat faces.
// It reads the solid from its standard input (MakeStepRequest writes it), judges it, and writes to the file that
// its argument names. What is wrong, or that nothing is, goes to the standard error.
#include "lacunaStepProtocol.h"

#include <APIHeaderSection_MakeHeader.hxx>
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepGProp.hxx>
#include <BRep_Builder.hxx>
#include <GProp_GProps.hxx>
#include <Geom_Plane.hxx>
#include <Interface_HArray1OfHAsciiString.hxx>
#include <Interface_Static.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Message_PrinterOStream.hxx>
#include <STEPControl_Controller.hxx>
#include <STEPControl_Writer.hxx>
#include <Standard_Failure.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Shell.hxx>
#include <TopoDS_Solid.hxx>
#include <TopoDS_Vertex.hxx>
#include <TopoDS_Wire.hxx>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <exception>
#include <iostream>
#include <stdexcept>
#include <string>
#include <unordered_map>
#include <vector>

namespace
{
constexpr double VolumeTolerance = 1e-4; // relative

struct Header
{
  std::string Title;
  std::string FileName;
  std::string System;
  std::vector<std::string> Description;
};

template <class Value>
Value Read(std::istream& in)
{
  Value value{};
  if (!(in >> value))
  {
    throw std::runtime_error("the solid is cut off");
  }
  return value;
}

std::string ReadLine(std::istream& in)
{
  std::string line;
  if (!std::getline(in, line))
  {
    throw std::runtime_error("the solid is cut off");
  }
  return line;
}

Header ReadHeader(std::istream& in)
{
  if (ReadLine(in) != lacuna::StepProtocol)
  {
    throw std::runtime_error("lacuna-step is of another version than Lacuna; install Lacuna again");
  }
  Header header;
  header.Title = ReadLine(in);
  header.FileName = ReadLine(in);
  header.System = ReadLine(in);
  header.Description.resize(std::stoul(ReadLine(in)));
  for (std::string& line : header.Description)
  {
    line = ReadLine(in);
  }
  return header;
}

//------------------------------------------------------------------------------
// Makes the topology: faces share edges, and edges share points.
class SolidMaker
{
public:
  explicit SolidMaker(std::istream& in)
    : In(in)
    , Tolerance(Read<double>(in))
  {
    this->Points.resize(Read<std::size_t>(in));
    this->Vertices.resize(this->Points.size());
    for (std::size_t k = 0; k < this->Points.size(); ++k)
    {
      this->Points[k] = gp_Pnt(this->ReadVector());
      this->Builder.MakeVertex(this->Vertices[k], this->Points[k], this->Tolerance);
    }
  }

  // One solid, or several together.
  TopoDS_Shape Make()
  {
    const auto count = Read<std::size_t>(this->In);
    TopoDS_Compound all;
    this->Builder.MakeCompound(all);
    TopoDS_Solid solid;
    for (std::size_t k = 0; k < count; ++k)
    {
      solid = this->MakeSolid();
      this->Builder.Add(all, solid);
    }
    return count == 1 ? TopoDS_Shape(solid) : TopoDS_Shape(all);
  }

  double GetVolume() const { return this->Volume; }

private:
  gp_XYZ ReadVector()
  {
    const auto x = Read<double>(this->In);
    const auto y = Read<double>(this->In);
    const auto z = Read<double>(this->In);
    return { x, y, z };
  }

  TopoDS_Solid MakeSolid()
  {
    this->Volume += Read<double>(this->In);
    TopoDS_Solid solid;
    this->Builder.MakeSolid(solid);
    for (auto shells = Read<std::size_t>(this->In); shells > 0; --shells)
    {
      TopoDS_Shell shell;
      this->Builder.MakeShell(shell);
      for (auto faces = Read<std::size_t>(this->In); faces > 0; --faces)
      {
        this->Builder.Add(shell, this->MakeFace());
      }
      shell.Closed(true);
      this->Builder.Add(solid, shell);
    }
    return solid;
  }

  TopoDS_Face MakeFace()
  {
    const gp_Pnt origin(this->ReadVector());
    const gp_Dir normal(this->ReadVector());
    TopoDS_Face face;
    this->Builder.MakeFace(face, new Geom_Plane(origin, normal), this->Tolerance);
    for (auto loops = Read<std::size_t>(this->In); loops > 0; --loops)
    {
      TopoDS_Wire wire;
      this->Builder.MakeWire(wire);
      std::vector<std::size_t> loop(Read<std::size_t>(this->In));
      for (std::size_t& id : loop)
      {
        id = Read<std::size_t>(this->In);
      }
      for (std::size_t k = 0; k < loop.size(); ++k)
      {
        this->Builder.Add(wire, this->GetEdge(loop[k], loop[(k + 1) % loop.size()]));
      }
      wire.Closed(true);
      this->Builder.Add(face, wire);
    }
    return face;
  }

  // The edge that leads from one point to another, which the faces on both sides have.
  TopoDS_Edge GetEdge(std::size_t from, std::size_t to)
  {
    const bool turned = from > to;
    const std::uint64_t key =
      static_cast<std::uint64_t>(turned ? to : from) << 32 | (turned ? from : to);
    TopoDS_Edge& edge = this->Edges[key];
    if (edge.IsNull())
    {
      const std::size_t first = turned ? to : from;
      const std::size_t last = turned ? from : to;
      BRepBuilderAPI_MakeEdge maker(this->Vertices.at(first), this->Vertices.at(last));
      if (!maker.IsDone())
      {
        throw std::runtime_error("two corners of a face are at one place");
      }
      edge = maker.Edge();
      this->Builder.UpdateEdge(edge, this->Tolerance);
    }
    return turned ? TopoDS::Edge(edge.Reversed()) : edge;
  }

  std::istream& In;
  double Tolerance; // mm
  double Volume = 0;
  BRep_Builder Builder;
  std::vector<gp_Pnt> Points;
  std::vector<TopoDS_Vertex> Vertices;
  std::unordered_map<std::uint64_t, TopoDS_Edge> Edges;
};

//------------------------------------------------------------------------------
void Write(const TopoDS_Shape& shape, const Header& header, const char* path)
{
  STEPControl_Writer writer;
  Interface_Static::SetCVal("write.step.schema", "AP214IS");
  Interface_Static::SetCVal("write.step.unit", "MM");
  Interface_Static::SetIVal("write.step.assembly", 0); // several solids are one product
  Interface_Static::SetIVal("write.surfacecurve.mode", 0);
  Interface_Static::SetCVal("write.step.product.name", header.Title.c_str());
  if (writer.Transfer(shape, STEPControl_AsIs) != IFSelect_RetDone)
  {
    throw std::runtime_error("OpenCASCADE cannot translate the solid");
  }
  APIHeaderSection_MakeHeader made(writer.Model());
  const auto text = [](const std::string& value)
  { return Handle(TCollection_HAsciiString)(new TCollection_HAsciiString(value.c_str())); };
  Handle(Interface_HArray1OfHAsciiString) description =
    new Interface_HArray1OfHAsciiString(1, static_cast<int>(header.Description.size()));
  for (std::size_t k = 0; k < header.Description.size(); ++k)
  {
    description->SetValue(static_cast<int>(k) + 1, text(header.Description[k]));
  }
  made.SetDescription(description);
  made.SetName(text(header.FileName));
  made.SetAuthorValue(1, text(""));
  made.SetOrganizationValue(1, text(""));
  made.SetAuthorisation(text(""));
  made.SetOriginatingSystem(text(header.System));
  if (writer.Write(path) != IFSelect_RetDone)
  {
    throw std::runtime_error("OpenCASCADE cannot write the file");
  }
}

// Throws unless shape is valid and has the volume that it should have.
void Check(const TopoDS_Shape& shape, double volume)
{
  if (!BRepCheck_Analyzer(shape).IsValid())
  {
    throw std::runtime_error("it is no valid solid");
  }
  GProp_GProps properties;
  BRepGProp::VolumeProperties(shape, properties);
  if (!(std::abs(properties.Mass() - volume) <= VolumeTolerance * volume))
  {
    throw std::runtime_error("its volume is " + std::to_string(properties.Mass()) +
      " mm3 there, and that of the mesh " + std::to_string(volume) + " mm3");
  }
}

void Make(const char* path)
{
  Message::DefaultMessenger()->RemovePrinters(STANDARD_TYPE(Message_PrinterOStream));
  STEPControl_Controller::Init();
  const Header header = ReadHeader(std::cin);
  SolidMaker maker(std::cin);
  const TopoDS_Shape shape = maker.Make();
  Check(shape, maker.GetVolume());
  Write(shape, header, path);
}
}

int main(int count, char** arguments)
{
  if (count != 2)
  {
    std::cerr << "lacuna-step is started by Lacuna's STEP Writer.\n";
    return EXIT_FAILURE;
  }
  try
  {
    Make(arguments[1]);
    std::cerr << lacuna::StepDone;
    return EXIT_SUCCESS;
  }
  catch (const Standard_Failure& failure)
  {
    std::cerr << "OpenCASCADE: " << failure.GetMessageString();
  }
  catch (const std::exception& error)
  {
    std::cerr << error.what();
  }
  return EXIT_FAILURE;
}

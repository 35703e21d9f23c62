#include <fmt/format.h>
#include <vtkCellArray.h>
#include <vtkCommand.h>
#include <vtkNew.h>
#include <vtkPolyData.h>
#include <vtkXMLPolyDataReader.h>

#include <algorithm>

#include "mesh/errors.h"
#include "mesh/io/read_vtk.h"
#include "mesh/read/polygons.h"

namespace palpate::mesh {
namespace {

/// VTK prints its errors unless somebody listens.
struct ErrorListener : vtkCommand {
    static ErrorListener* New() { return new ErrorListener; }
    void Execute(vtkObject*, unsigned long event, void* text) override {
        if (event == vtkCommand::ErrorEvent && message.empty()) message = static_cast<const char*>(text);
    }
    std::string message;
};

/// The last line of VTK's message says what is wrong.
std::string last_line(std::string text) {
    text.erase(std::find_if_not(text.rbegin(), text.rend(), [](char c) { return c == '\n'; }).base(), text.end());
    return text.substr(text.find_last_of('\n') + 1);
}

void add_polygons(vtkCellArray* cells, Polygons& polygons) {
    vtkIdType size = 0;
    const vtkIdType* corners = nullptr;
    for (cells->InitTraversal(); cells->GetNextCell(size, corners);) {
        polygons.begin_polygon();
        for (vtkIdType i = 0; i < size; ++i) polygons.corners.push_back(static_cast<int>(corners[i]));
    }
}

/// A strip is a row of triangles of which every other one is turned.
void add_strips(vtkCellArray* cells, Polygons& polygons) {
    vtkIdType size = 0;
    const vtkIdType* corners = nullptr;
    for (cells->InitTraversal(); cells->GetNextCell(size, corners);)
        for (vtkIdType i = 0; i + 2 < size; ++i) {
            polygons.begin_polygon();
            for (const vtkIdType j : {i, i + 1 + i % 2, i + 2 - i % 2})
                polygons.corners.push_back(static_cast<int>(corners[j]));
        }
}

}  // namespace

Polygons read_vtp(const std::string& content, const std::filesystem::path& file) {
    vtkNew<vtkXMLPolyDataReader> reader;
    vtkNew<ErrorListener> listener;
    reader->AddObserver(vtkCommand::ErrorEvent, listener);
    reader->AddObserver(vtkCommand::WarningEvent, listener);
    reader->SetReaderErrorObserver(listener);
    reader->SetParserErrorObserver(listener);
    reader->ReadFromInputStringOn();
    reader->SetInputString(content);
    read_vtk(file, content, [&] { reader->Update(); });
    vtkPolyData* poly = reader->GetOutput();
    if (!listener->message.empty() || reader->GetErrorCode() != 0 || poly == nullptr)
        throw InvalidInput(fmt::format("{}: is no VTP that can be read ({}). Export it again as VTK XML PolyData.",
                                       file.string(), last_line(listener->message)));

    Polygons polygons;
    polygons.points.resize(static_cast<std::size_t>(poly->GetNumberOfPoints()));
    for (std::size_t v = 0; v < polygons.points.size(); ++v)
        poly->GetPoint(static_cast<vtkIdType>(v), polygons.points[v].data());
    add_polygons(poly->GetPolys(), polygons);
    add_strips(poly->GetStrips(), polygons);
    return polygons;
}

}  // namespace palpate::mesh

#include "mesh/formats/vtk/vtk_errors.h"

#include <SMP/Common/vtkSMPToolsAPI.h>
#include <vtkLogger.h>
#include <vtkNew.h>
#include <vtkOutputWindow.h>

namespace palpate::mesh {

namespace {

thread_local bool error_in_this_thread = false;

/// Where VTK sends what it would print. Its readers make objects of their own that nobody else can listen to.
class SilentWindow : public vtkOutputWindow {
public:
    static SilentWindow* New() { return new SilentWindow; }
    void DisplayText(const char*) override {}
    void DisplayErrorText(const char*) override { error_in_this_thread = true; }
    void DisplayWarningText(const char*) override {}
    void DisplayGenericWarningText(const char*) override {}
    void DisplayDebugText(const char*) override {}
};

bool prepare_vtk() {
    vtkNew<SilentWindow> window;
    vtkOutputWindow::SetInstance(window);
    vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_OFF);
    // <vtkSMPTools.h> is no C++20. A child process that is forked while VTK begins a thread may inherit a lock that
    // nobody will open.
    vtk::detail::smp::vtkSMPToolsAPI::GetInstance().SetBackend("Sequential");
    return true;
}

}  // namespace

VtkErrors::VtkErrors() {
    [[maybe_unused]] static const bool prepared = prepare_vtk();
    error_in_this_thread = false;
}

bool VtkErrors::heard() const { return error_in_this_thread; }

}  // namespace palpate::mesh

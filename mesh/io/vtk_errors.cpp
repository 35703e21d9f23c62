#include "mesh/io/vtk_errors.h"

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

bool install_silent_window() {
    vtkNew<SilentWindow> window;
    vtkOutputWindow::SetInstance(window);
    vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_OFF);
    return true;
}

}  // namespace

VtkErrors::VtkErrors() {
    [[maybe_unused]] static const bool installed = install_silent_window();
    error_in_this_thread = false;
}

bool VtkErrors::heard() const { return error_in_this_thread; }

}  // namespace palpate::mesh

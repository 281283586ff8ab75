# SPDX-License-Identifier: BSD-3-Clause
# Finds the VTK to build against: ParaView's own, or a plain one. Sets lacuna_flavor.

# One list, used here and again by LacunaConfig.cmake. Never find_package(VTK) without
# COMPONENTS: that asks for every third party of every VTK module (Qt, HDF5, ...).
set(lacuna_vtk_components
  CommonComputationalGeometry CommonCore CommonDataModel CommonExecutionModel CommonMath CommonMisc CommonSystem
  CommonTransforms FiltersCore FiltersExtraction FiltersGeneral FiltersGeometry FiltersModeling
  FiltersSources ImagingCore ImagingGeneral IOCore IOGeometry IOImage IOXML jsoncpp ParallelCore)
if (LACUNA_WITH_PARAVIEW)
  # With COMPONENTS, Debian 12 needs few -dev packages next to paraview-dev; without, about
  # 15 more. RemotingViews brings the X11 and GLEW targets of the C++ rendering tests.
  include(Plugins/Package/LacunaParaViewPython.cmake)
  find_package(ParaView 5.11 REQUIRED
    COMPONENTS RemotingCore RemotingServerManager RemotingViews)
  if (LACUNA_WITH_QT)
    # The Qt of ParaView. ParaView 5.11 has Qt 5 and does not say so. lacuna_qt is Qt5 or Qt6.
    set(lacuna_qt Qt5)
    set(lacuna_qt_components Widgets OpenGL)
    set(lacuna_qt_packages "qtbase5-dev libqt5opengl5-dev")
    if (PARAVIEW_QT_MAJOR_VERSION GREATER_EQUAL 6)
      set(lacuna_qt "Qt${PARAVIEW_QT_MAJOR_VERSION}")
      set(lacuna_qt_components Widgets OpenGL OpenGLWidgets)
      set(lacuna_qt_packages "qt6-base-dev")
    endif ()
    # what ParaView's component libraries link; asking for them as COMPONENTS would ask for Qt's help
    find_package(${lacuna_qt} QUIET COMPONENTS ${lacuna_qt_components})
    if (NOT ${lacuna_qt}_FOUND)
      message(FATAL_ERROR "LACUNA_WITH_QT needs ${lacuna_qt} (Debian: ${lacuna_qt_packages}); "
        "turn it off to do without the buttons in ParaView's properties panel")
    endif ()
  endif ()
  set(lacuna_flavor "pv${ParaView_VERSION_MAJOR}.${ParaView_VERSION_MINOR}")
else ()
  # ParaView carries a whole VTK: it serves when no plain VTK is installed.
  file(GLOB lacuna_paraview_vtk LIST_DIRECTORIES ON
    "/usr/lib/${CMAKE_LIBRARY_ARCHITECTURE}/cmake/paraview-*/vtk")
  find_package(VTK 9.1 REQUIRED
    COMPONENTS ${lacuna_vtk_components}
    OPTIONAL_COMPONENTS TestingCore TestingRendering RenderingOpenGL2 InteractionStyle
      Python WrappingPythonCore FiltersPoints ImagingHybrid
    PATHS ${lacuna_paraview_vtk})
  if (LACUNA_WRAP_PYTHON AND NOT VTK_WRAP_PYTHON)
    message(FATAL_ERROR "${VTK_DIR} was built without Python: give LACUNA_WRAP_PYTHON=OFF, "
      "and BUILD_TESTING=OFF where it was also built without its modules for tests")
  endif ()
  set(lacuna_flavor "vtk${VTK_MAJOR_VERSION}.${VTK_MINOR_VERSION}")
endif ()

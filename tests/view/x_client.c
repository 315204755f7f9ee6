/* What xdotool cannot do: `x_client drop FILE...` drops files onto the window that takes them, as a file manager does (XDND, version 5:
 * freedesktop.org's "Drag-and-Drop Protocol for the X Window System"), and `x_client dpi N` says how dense the screen is. Ends with 0 when
 * the window says that it has taken them. */
#include <X11/Xatom.h>
#include <X11/Xlib.h>

#include <ctype.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static Display* display;

static Atom atom(const char* name) { return XInternAtom(display, name, False); }

/* The first of the root's windows that takes drops; without a window manager the viewer's is one of them. */
static Window taker(void) {
  Window root, parent, *windows = NULL, found = None;
  unsigned count = 0;
  if (XQueryTree(display, DefaultRootWindow(display), &root, &parent, &windows, &count) == 0) return None;
  for (unsigned k = 0; k < count && found == None; ++k) {
    Atom type = None;
    int format = 0;
    unsigned long entries = 0, left = 0;
    unsigned char* data = NULL;
    XGetWindowProperty(display, windows[k], atom("XdndAware"), 0, 1, False, AnyPropertyType, &type, &format, &entries, &left, &data);
    if (type != None) found = windows[k];
    if (data != NULL) XFree(data);
  }
  if (windows != NULL) XFree(windows);
  return found;
}

static void send(Window target, const char* message, const long data[5]) {
  XEvent event;
  memset(&event, 0, sizeof event);
  event.xclient.type = ClientMessage;
  event.xclient.window = target;
  event.xclient.message_type = atom(message);
  event.xclient.format = 32;
  for (int k = 0; k < 5; ++k) event.xclient.data.l[k] = data[k];
  XSendEvent(display, target, False, NoEventMask, &event);
}

/* Answers what the target asks until it sends this message; the message's second number. */
static long wait_for(const char* message, const char* uris) {
  for (;;) {
    XEvent event;
    XNextEvent(display, &event);
    if (event.type == ClientMessage && event.xclient.message_type == atom(message)) return event.xclient.data.l[1];
    if (event.type != SelectionRequest) continue;
    const XSelectionRequestEvent* asked = &event.xselectionrequest;
    XChangeProperty(display, asked->requestor, asked->property, asked->target, 8, PropModeReplace, (const unsigned char*)uris,
                    (int)strlen(uris));
    XEvent answer;
    memset(&answer, 0, sizeof answer);
    answer.xselection.type = SelectionNotify;
    answer.xselection.requestor = asked->requestor;
    answer.xselection.selection = asked->selection;
    answer.xselection.target = asked->target;
    answer.xselection.property = asked->property;
    answer.xselection.time = asked->time;
    XSendEvent(display, asked->requestor, False, NoEventMask, &answer);
  }
}

/* As lines of file:// with what is no letter, digit or slash in hexadecimal. */
static void add_uri(char* uris, size_t room, const char* file) {
  size_t at = strlen(uris);
  at += (size_t)snprintf(uris + at, room - at, "file://");
  for (; *file != '\0' && at + 8 < room; ++file)
    at += (size_t)snprintf(uris + at, room - at, isalnum((unsigned char)*file) || *file == '/' ? "%c" : "%%%02x", (unsigned char)*file);
  snprintf(uris + at, room - at, "\r\n");
}

static int drop(int count, char** files) {
  static char uris[65536];
  for (int k = 0; k < count; ++k) add_uri(uris, sizeof uris, files[k]);
  const Window target = taker(), source = XCreateSimpleWindow(display, DefaultRootWindow(display), 0, 0, 1, 1, 0, 0, 0);
  if (target == None) return 1;
  XSetSelectionOwner(display, atom("XdndSelection"), source, CurrentTime);
  const long of = (long)source, list = (long)atom("text/uri-list"), copies = (long)atom("XdndActionCopy");
  send(target, "XdndEnter", (long[5]){of, 5L << 24, list, None, None});
  send(target, "XdndPosition", (long[5]){of, 0, 500L << 16 | 300, CurrentTime, copies});
  if ((wait_for("XdndStatus", uris) & 1) == 0) return 2;   /* it does not want them */
  send(target, "XdndDrop", (long[5]){of, 0, CurrentTime, 0, 0});
  return wait_for("XdndFinished", uris) == 0 ? 3 : 0;   /* GLFW has the number of bytes there, and not a flag */
}

static int set_dpi(const char* dots) {
  char resource[64];
  snprintf(resource, sizeof resource, "Xft.dpi:\t%s\n", dots);
  XChangeProperty(display, DefaultRootWindow(display), XA_RESOURCE_MANAGER, XA_STRING, 8, PropModeReplace,
                  (const unsigned char*)resource, (int)strlen(resource));
  return 0;
}

int main(int count, char** words) {
  alarm(20);   /* a target that says nothing ends this */
  display = XOpenDisplay(NULL);
  if (display == NULL || count < 3) return 64;
  const int done = strcmp(words[1], "drop") == 0 ? drop(count - 2, words + 2) : set_dpi(words[2]);
  XCloseDisplay(display);
  return done;
}

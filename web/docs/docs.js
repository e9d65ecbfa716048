// @ts-check
// The page at /docs: every route with its examples, ready to be tried.

// @ts-ignore: Swagger UI is a plain script that leaves its name behind.
const SwaggerUIBundle = window.SwaggerUIBundle;

SwaggerUIBundle({ url: "/openapi.json", dom_id: "#swagger-ui", deepLinking: true });

(* The language of statements: vectors, matrices, conditions and derivatives are read away, so that plain trees are left.
   Section 9 of docs/certificates.md, without integrals, sums, products and limits: they are outside. *)

open Text
open Tree

type value = Scalar of tree | Matrix of tree list list

(* The signs that a tree may have *)
type signs = { below : bool; null : bool; above : bool }

type context = {
  shapes : (string * string list list) list;
  declared : string list; (* the symbols *)
  rates : (string * value option) list Lazy.t; (* by the name of a symbol or of a shape *)
  mutable said : tree list; (* all that is typed, and so has to have a value *)
  mutable given : tree list; (* what is supposed to be >= 0 *)
  mutable zeros : tree list; (* what is supposed to be 0 *)
  mutable known : (tree * signs) list; (* what answers say of signs *)
  mutable plan : bool list; (* answers to the questions that come first in this case *)
  mutable answers : bool list; (* answers so far, the last one first *)
  mutable quiet : bool; (* in a branch that is not taken *)
  mutable branches : int; (* how many were read *)
}

(* Tokens *)

let read_marks = [ "!="; ">="; "<="; "**"; "="; ">"; "<"; "@"; "["; "]"; "."; "+"; "-"; "*"; "/"; "("; ")"; "," ]

let read_tokens s =
  if s = "" || String.length s > longest then refuse "expression: expected 1 to %d characters" longest;
  let n = String.length s in
  let rec name j = if j < n && (is_letter s.[j] || is_digit s.[j] || s.[j] = '_') then name (j + 1) else j in
  let starts i mark = i + String.length mark <= n && String.sub s i (String.length mark) = mark in
  let rec go i done_ =
    if i >= n then List.rev (End :: done_)
    else if s.[i] = ' ' then go (i + 1) done_
    else if is_digit s.[i] then let t, j = read_number s i in go j (t :: done_)
    else if is_letter s.[i] then let j = name i in go j (Name (String.sub s i (j - i)) :: done_)
    else
      match List.find_opt (starts i) read_marks with
      | Some mark -> go (i + String.length mark) (Mark mark :: done_)
      | None -> refuse "expression: unexpected character %C" s.[i]
  in
  go 0 []

(* Values *)

let rows_of = function Scalar t -> [ [ t ] ] | Matrix m -> m
let entries v = List.concat (rows_of v)
let scalar what = function Scalar t -> t | Matrix _ -> refuse "%s: expected a number" what
let matrix what = function Matrix m -> m | Scalar _ -> refuse "%s: expected a matrix" what

let vector what v =
  let one = function [ t ] -> t | _ -> refuse "%s: expected a vector" what in
  List.map one (matrix what v)

let width m = List.length (List.hd m)
let of_vector l = Matrix (List.map (fun t -> [ t ]) l)

let check_size n = if n < 1 || n > 64 then refuse "a matrix has 1 to 64 rows and columns"

let make_matrix m =
  check_size (List.length m);
  check_size (width m);
  if List.exists (fun row -> List.length row <> width m) m then refuse "rows of different lengths";
  Matrix m

let map f = function Scalar t -> Scalar (f t) | Matrix m -> Matrix (List.map (List.map f) m)

let shape = function Scalar _ -> (0, 0) | Matrix m -> (List.length m, width m)
let entry i j v = List.nth (List.nth (rows_of v) i) j

(* Entry by entry the tree that [make] gives of the entries of all values, which have one shape *)
let combine make values =
  let first = List.hd values in
  if List.exists (fun v -> shape v <> shape first) values then refuse "different shapes";
  match first with
  | Scalar _ -> Scalar (make (List.map (entry 0 0) values))
  | Matrix m -> Matrix (List.mapi (fun i row -> List.mapi (fun j _ -> make (List.map (entry i j) values)) row) m)

let sum_of_parts = function [ t ] -> t | l -> Sum l
let product_of_parts = function [ t ] -> t | l -> Prod l

(* Numbers and at most one matrix *)
let multiply values =
  let is_matrix = function Matrix _ -> true | Scalar _ -> false in
  match List.filter is_matrix values with
  | [] -> Scalar (product_of_parts (List.map (scalar "product") values))
  | [ (Matrix _ as m) ] ->
      let with_entry t = product_of_parts (List.map (function Scalar s -> s | Matrix _ -> t) values) in
      map with_entry m
  | _ -> refuse "products of matrices are written with @"

let transpose m = List.init (width m) (fun j -> List.map (fun row -> List.nth row j) m)

let times a b =
  let a = matrix "@" a and b = matrix "@" b in
  if width a <> List.length b then refuse "@: different sizes";
  let columns = transpose b in
  let entry row column = sum_of_parts (List.map2 (fun x y -> Prod [ x; y ]) row column) in
  match List.map (fun row -> List.map (entry row) columns) a with [ [ t ] ] -> Scalar t | m -> Matrix m

let square most what v =
  let m = matrix what v in
  if List.length m <> width m || width m > most then refuse "%s: expected a square matrix of at most %d rows" what most;
  m

let without k l = List.filteri (fun i _ -> i <> k) l
let minor i j m = List.map (without j) (without i m)
let odd_negated k t = if k land 1 = 1 then negate t else t

let rec determinant m =
  match m with
  | [] -> one
  | row :: _ -> sum_of_parts (List.mapi (fun j a -> odd_negated j (Prod [ a; determinant (minor 0 j m) ])) row)

let inverse m =
  let below = Pow (determinant m, Num Q.minus_one) in
  let entry i j = Prod [ odd_negated (i + j) (determinant (minor j i m)); below ] in
  let n = List.length m in
  Matrix (List.init n (fun i -> List.init n (entry i)))

let product a b = Prod [ a; b ]

let cross u v =
  match (u, v) with
  | [ u1; u2; u3 ], [ v1; v2; v3 ] ->
      let pair a b c d = subtract (product a b) (product c d) in
      [ pair u2 v3 u3 v2; pair u3 v1 u1 v3; pair u1 v2 u2 v1 ]
  | _ -> refuse "cross: expected vectors of 3 entries"

let dot u v =
  if List.length u <> List.length v then refuse "dot: different shapes";
  sum_of_parts (List.map2 product u v)

let qmul p q =
  match (p, q) with
  | a :: u, b :: v when List.length u = 3 && List.length v = 3 ->
      let join x y z = Sum [ product a x; product b y; z ] in
      subtract (product a b) (dot u v) :: List.map2 (fun (x, y) z -> join y x z) (List.combine u v) (cross u v)
  | _ -> refuse "qmul: expected vectors of 4 entries"

let rotation = function
  | [ w; x; y; z ] ->
      let p = product in
      let twice s = Prod [ number 2; s ] in
      let plus a b = twice (Sum [ a; b ]) and less a b = twice (subtract a b) in
      let diagonal a b c d = Sum [ p a a; p b b; negate (p c c); negate (p d d) ] in
      [
        [ diagonal w x y z; less (p x y) (p w z); plus (p x z) (p w y) ];
        [ plus (p x y) (p w z); diagonal w y x z; less (p y z) (p w x) ];
        [ less (p x z) (p w y); plus (p y z) (p w x); diagonal w z x y ];
      ]
  | _ -> refuse "rot: expected a vector of 4 entries"

let skew = function
  | [ a; b; c ] -> [ [ zero; negate c; b ]; [ c; zero; negate a ]; [ negate b; a; zero ] ]
  | _ -> refuse "skew: expected a vector of 3 entries"

let size_of what = function
  | Scalar (Num q) when is_whole q && Q.sign q > 0 && Q.leq q (Q.of_int 64) -> Z.to_int q.Q.num
  | _ -> refuse "%s: expected a literal size from 1 to 64" what

let diagonal l = Matrix (List.mapi (fun i t -> List.mapi (fun j _ -> if i = j then t else zero) l) l)

let matrix_function name args =
  let v what = vector what in
  match (name, args) with
  | "transpose", [ a ] -> Some (Matrix (transpose (matrix name a)))
  | "cross", [ a; b ] -> Some (of_vector (cross (v name a) (v name b)))
  | "dot", [ a; b ] -> Some (Scalar (dot (v name a) (v name b)))
  | "norm", [ a ] -> let u = v name a in Some (Scalar (apply "sqrt" (dot u u)))
  | "skew", [ a ] -> Some (Matrix (skew (v name a)))
  | "det", [ a ] -> Some (Scalar (determinant (square 5 name a)))
  | "inv", [ a ] -> Some (inverse (square 4 name a))
  | "trace", [ a ] -> Some (Scalar (sum_of_parts (List.mapi (fun i row -> List.nth row i) (square 64 name a))))
  | "eye", [ n ] -> Some (diagonal (List.init (size_of name n) (fun _ -> one)))
  | "zeros", [ m; n ] ->
      let m = size_of name m and n = size_of name n in
      Some (Matrix (List.init m (fun _ -> List.init n (fun _ -> zero))))
  | "diag", [ (Matrix _ as u) ] -> Some (diagonal (v name u))
  | "diag", (_ :: _ as l) -> Some (diagonal (List.map (scalar name) l))
  | "qmul", [ p; q ] -> Some (of_vector (qmul (v name p) (v name q)))
  | "conj", [ q ] -> (
      match v name q with
      | w :: l when List.length l = 3 -> Some (of_vector (w :: List.map negate l))
      | _ -> refuse "conj: expected a vector of 4 entries")
  | "rot", [ q ] -> Some (Matrix (rotation (v name q)))
  | _ -> None

(* Derivatives *)

let say context t =
  match t with
  | Num _ | Sym _ -> ()
  | _ -> if not (context.quiet || List.mem t context.said) then context.said <- t :: context.said

(* f has to have a value and to be differentiable. *)
let say_smooth context f =
  say context f;
  let term = function
    | Above, t -> apply "log" t
    | AtLeast, t -> apply "sqrt" t
    | _, t -> Pow (t, Num Q.minus_one)
  in
  List.iter (fun c -> say context (term c)) (conditions 2 [ f ])

let rates_by_symbol context =
  let one (name, rate) =
    match List.assoc_opt name context.shapes with
    | None -> [ (name, Option.map (scalar "rates") rate) ]
    | Some rows ->
        let names = List.concat rows in
        let values = match rate with None -> List.map (fun _ -> None) names | Some v -> List.map Option.some (entries v) in
        List.combine names values
  in
  let all = List.concat_map one (Lazy.force context.rates) in
  let names = List.map fst all in
  if List.length (List.sort_uniq compare names) <> List.length names then refuse "rates: one symbol has one rate";
  all

let derive_by_time context f =
  say_smooth context f;
  let rates = rates_by_symbol context in
  let share s =
    match List.assoc_opt s rates with
    | None -> zero
    | Some None -> refuse "no rate is known of %s" s
    | Some (Some rate) ->
        say context rate;
        let slope = Calculus.derive s f in
        if equal slope zero || equal rate zero then zero else Calculus.product' [ slope; rate ]
  in
  Calculus.sum' (List.map share (Names.elements (symbols f)))

let derive_by_symbol context s times f =
  let has_rate = List.mem_assoc s (rates_by_symbol context) in
  let rec go n f =
    if n = 0 then f
    else if has_rate then go (n - 1) (derive_by_time context f)
    else begin
      say_smooth context f;
      go (n - 1) (Calculus.derive s f)
    end
  in
  go times f

let outside_words = [ "integral"; "limit"; "floor"; "erf"; "expm"; "E"; "cov" ]

(* sum and product with rational ends, written out *)
let write_out name low high term =
  let whole what t =
    match !constant t with
    | Some q when is_whole q && Z.fits_int q.Q.num -> Z.to_int q.Q.num
    | _ -> outside "%s with %s that is no whole number" name what
  in
  let low = whole "a low end" low and high = whole "a high end" high in
  if high - low >= 400 then refuse "%s: more than 400 terms" name;
  match List.init (max 0 (high - low + 1)) (fun k -> term (number (low + k))) with
  | [] -> if name = "sum" then zero else one
  | l -> if name = "sum" then Sum (zero :: l) else Prod (one :: l)

(* Suppositions *)

let join t l = if List.mem t l then l else l @ [ t ]
let signs_of = function
  | Equal -> { below = false; null = true; above = false }
  | Unequal -> { below = true; null = false; above = true }
  | AtLeast -> { below = false; null = true; above = true }
  | Above -> { below = false; null = false; above = true }

let distance a b = match (a, b) with a, Num q when Q.sign q = 0 -> a | Num q, b when Q.sign q = 0 -> negate b | _ -> subtract a b

(* Supposes d relation 0. *)
let suppose_sign context d relation =
  say context d;
  (match relation with
  | Equal -> context.zeros <- join d context.zeros
  | Unequal -> ()
  | AtLeast | Above -> context.given <- join d context.given);
  if relation = Above || relation = Unequal then say context (Pow (d, Num Q.minus_one))

let opposite_of d = function
  | Equal -> (d, Unequal)
  | Unequal -> (d, Equal)
  | Above -> (negate d, AtLeast)
  | AtLeast -> (negate d, Above)

(* A condition as d relation 0, or its opposite *)
let read_relation mark x y =
  match mark with
  | "=" -> (distance x y, Equal)
  | "!=" -> (distance x y, Unequal)
  | ">" -> (distance x y, Above)
  | ">=" -> (distance x y, AtLeast)
  | "<" -> (distance y x, Above)
  | _ -> (distance y x, AtLeast)

let suppose context (x, mark, y) =
  match (x, mark, y) with
  | _, "=", _ ->
      let all = combine (function [ a; b ] -> distance a b | _ -> assert false) [ x; y ] in
      List.iter (fun d -> suppose_sign context d Equal) (entries all)
  | Scalar x, mark, Scalar y ->
      let d, relation = read_relation mark x y in
      suppose_sign context d relation
  | _ -> refuse "given: matrices have no other relation"

(* Cases: the answer to the question whether d relation 0 holds *)

let known_signs context d =
  let both a b = { below = a.below && b.below; null = a.null && b.null; above = a.above && b.above } in
  let turned s = { s with below = s.above; above = s.below } in
  let learn found (other, signs) =
    if Algebra.vanishes (subtract d other) then both found signs
    else if Algebra.vanishes (Sum [ d; other ]) then both found (turned signs)
    else found
  in
  List.fold_left learn { below = true; null = true; above = true } context.known

let rec ask context d relation =
  if context.quiet then true
  else if relation = Unequal then not (ask context d Equal)
  else begin
    say context d;
    let may = known_signs context d and yes = signs_of relation in
    let implies a b = (not a) || b in
    if implies may.below yes.below && implies may.null yes.null && implies may.above yes.above then true
    else if not ((may.below && yes.below) || (may.null && yes.null) || (may.above && yes.above)) then false
    else if relation = Above && not may.below then not (ask context d Equal)
    else if relation = AtLeast && not may.above then ask context d Equal
    else begin
      let answer = match context.plan with [] -> true | a :: rest -> context.plan <- rest; a in
      context.answers <- answer :: context.answers;
      if List.length context.answers > 128 then refuse "more than 128 cases";
      let d, relation = if answer then (d, relation) else opposite_of d relation in
      suppose_sign context d relation;
      (* hypotheses are no answers: they do not decide a question *)
      context.known <- (d, signs_of relation) :: context.known;
      answer
    end
  end

(* The plan of the next case, if there is one: the last yes becomes a no. *)
let rec next_plan = function [] -> None | false :: earlier -> next_plan earlier | true :: earlier -> Some (List.rev (false :: earlier))

let choose context name args =
  let chosen x y =
    let first = ask context (subtract y x) AtLeast in
    if (name = "min") = first then x else y
  in
  match (name, args) with
  | "sign", [ x ] -> if ask context x Equal then zero else if ask context x Above then one else number (-1)
  | ("min" | "max"), (x :: (_ :: _ as rest)) -> List.fold_left chosen x rest
  | _ -> refuse "%s: another number of arguments" name

let relation_marks = [ "="; "!="; ">"; ">="; "<"; "<=" ]

let call context name args =
  match (name, args) with
  | "dot_", [ f ] -> map (derive_by_time context) f
  | "diff", [ f; Scalar (Sym s) ] when List.mem s context.declared -> map (derive_by_symbol context s 1) f
  | "diff", [ f; Scalar (Sym s); Scalar (Num n) ] when List.mem s context.declared && is_whole n && Q.sign n > 0 && Q.leq n (Q.of_int 8) ->
      map (derive_by_symbol context s (Z.to_int n.Q.num)) f
  | _ -> (
      match matrix_function name args with
      | Some v -> v
      | None ->
          if arguments_of name <> List.length args then refuse "expression: %s with %d arguments" name (List.length args);
          Scalar (Fun (name, List.map (scalar name) args)))

(* Grammar *)

let rec read_sum context r =
  let first = read_product context r in
  let rec go parts =
    match next r with
    | Mark "+" -> drop r; let v = read_product context r in go (v :: parts)
    | Mark "-" -> drop r; let v = read_product context r in go (map negate v :: parts)
    | _ -> List.rev parts
  in
  combine sum_of_parts (go [ first ])

and read_product context r =
  let rec go factors =
    match next r with
    | Mark "*" -> drop r; let v = read_signed context r in go (v :: factors)
    | Mark "/" ->
        drop r;
        let v = scalar "a divisor" (read_signed context r) in
        go (Scalar (Pow (v, Num Q.minus_one)) :: factors)
    | Mark "@" ->
        drop r;
        let left = typed context (multiply (List.rev factors)) in
        let right = read_signed context r in
        go [ typed context (times left right) ]
    | _ -> ( match factors with [ v ] -> v | l -> multiply (List.rev l))
  in
  go [ read_signed context r ]

and read_signed context r =
  match next r with
  | Mark "+" -> drop r; deeper r (read_signed context)
  | Mark "-" -> drop r; map negate (deeper r (read_signed context))
  | _ ->
      let base = read_entry context r in
      if next r = Mark "**" then begin
        drop r;
        let exponent = deeper r (read_signed context) in
        Scalar (Pow (scalar "a base" base, scalar "an exponent" exponent))
      end
      else base

and read_entry context r =
  let rec go v =
    match next r with
    | Mark "." ->
        drop r;
        if next r <> Name "T" then refuse "expression: expected .T";
        drop r;
        go (Matrix (transpose (matrix ".T" v)))
    | Mark "[" -> drop r; go (Scalar (read_index r v))
    | _ -> v
  in
  go (typed context (read_value context r))

(* All entries of a matrix that is typed have to have a value. *)
and typed context v =
  (match v with Matrix m -> List.iter (List.iter (say context)) m | Scalar _ -> ());
  v

and read_index r v =
  let literal () =
    match next r with
    | Number q when is_whole q && Q.sign q > 0 && Q.leq q (Q.of_int 64) -> drop r; Z.to_int q.Q.num - 1
    | _ -> refuse "an index is a literal number from 1"
  in
  let m = matrix "an index" v in
  let i = literal () in
  let j = if next r = Mark "," then (drop r; literal ()) else if width m = 1 then 0 else refuse "a matrix has two indices" in
  take r "]";
  match Option.bind (List.nth_opt m i) (fun row -> List.nth_opt row j) with
  | Some t -> t
  | None -> refuse "an index beyond the matrix"

and read_value context r =
  match next r with
  | Number q -> drop r; Scalar (Num q)
  | Mark "(" ->
      drop r;
      let v = deeper r (read_sum context) in
      take r ")"; v
  | Mark "[" -> drop r; deeper r (read_rows context)
  | Name name -> (
      drop r;
      match next r with
      | Mark "(" ->
          if List.mem name outside_words then outside "%s in a statement" name;
          drop r;
          if name = "where" then read_where context r
          else if name = "sum" || name = "product" then read_terms context name r
          else if List.mem name [ "min"; "max"; "sign" ] then begin
            let args = List.map (scalar name) (read_list context r ")") in
            List.iter (say context) args;
            context.branches <- context.branches + 1;
            Scalar (choose context name args)
          end
          else begin
            let before = context.branches in
            let args = List.map (typed context) (read_list context r ")") in
            if context.branches > before && List.mem name [ "diff"; "dot_" ] then outside "a derivative of cases";
            call context name args
          end
      | _ when name = "pi" -> Scalar Pi
      | _ -> (
          match List.assoc_opt name context.shapes with
          | Some rows -> Matrix (List.map (List.map (fun s -> Sym s)) rows)
          | None -> Scalar (Sym name)))
  | _ -> refuse "expression: expected a number, a name or a parenthesis"

(* sum(f, k, a, b): what is typed in f has to have a value for every number in the place of k. *)
and read_terms context name r =
  let before = context.said and branches = context.branches and quiet = context.quiet in
  context.said <- [];
  context.quiet <- false;
  let f = scalar name (deeper r (read_sum context)) in
  say context f;
  let typed_inside = List.rev context.said in
  context.said <- before;
  context.quiet <- quiet;
  take r ",";
  let k = match next r with Name k when k <> "pi" && k <> "oo" -> drop r; k | _ -> refuse "%s: expected a variable" name in
  if List.mem_assoc k context.shapes || List.mem_assoc k (Lazy.force context.rates) then refuse "%s: a variable that is in use" name;
  let stands_in_rate (_, rate) = match rate with Some t -> Names.mem k (symbols t) | None -> false in
  if List.exists stands_in_rate (rates_by_symbol context) then outside "%s: a variable that stands in a rate" name;
  let finish () = take r ","; scalar name (deeper r (read_sum context)) in
  let low = finish () in
  let high = finish () in
  take r ")";
  if context.branches > branches then outside "%s: cases inside" name;
  let term value =
    let place = put [ (k, value) ] in
    List.iter (fun t -> say context (place t)) typed_inside;
    place f
  in
  Scalar (write_out name low high term)

(* where(condition, a, b): what is read in the branch that is not taken leaves no trace. *)
and read_where context r =
  context.branches <- context.branches + 1;
  let side () = match deeper r (read_sum context) with Scalar t -> say context t; t | Matrix _ -> outside "a condition of matrices" in
  let x = side () in
  let mark = match next r with Mark m when List.mem m relation_marks -> drop r; m | _ -> refuse "where: expected a relation" in
  let y = side () in
  let d, relation = read_relation mark x y in
  let first = ask context d relation in
  let branch taken =
    take r ",";
    let before = context.quiet in
    context.quiet <- before || not taken;
    let v = typed context (deeper r (read_sum context)) in
    (match v with Scalar t -> say context t | Matrix _ -> ());
    context.quiet <- before;
    v
  in
  let a = branch first in
  let b = branch (not first) in
  take r ")";
  if shape a <> shape b then refuse "where: different shapes";
  if first then a else b

(* Values up to a closing mark *)
and read_list context r closing =
  let rec go done_ =
    let done_ = deeper r (read_sum context) :: done_ in
    if next r = Mark "," then (drop r; go done_) else (take r closing; List.rev done_)
  in
  go []

and read_rows context r =
  let numbers () = List.map (scalar "an entry") (read_list context r "]") in
  if next r <> Mark "[" then make_matrix (List.map (fun t -> [ t ]) (numbers ()))
  else
    let rec go done_ =
      take r "[";
      let done_ = numbers () :: done_ in
      if next r = Mark "," then (drop r; go done_) else (take r "]"; List.rev done_)
    in
    make_matrix (go [])

let say_value context v =
  List.iter (say context) (entries v);
  v

let read_value_of context text =
  let r = { rest = read_tokens text; depth = 0 } in
  let v = read_sum context r in
  if next r <> End then refuse "expression: expected an operator";
  say_value context v

(* The two sides of a condition and its relation *)
let read_condition context text =
  let r = { rest = read_tokens text; depth = 0 } in
  let x = read_sum context r in
  let mark =
    match next r with
    | Mark (("=" | "!=" | ">" | ">=" | "<" | "<=") as m) -> drop r; m
    | _ -> refuse "given: expected a relation"
  in
  let y = read_sum context r in
  if next r <> End then refuse "given: expected the end of the condition";
  (say_value context x, mark, say_value context y)

(* Declarations *)

let read_shapes declared value =
  let read (name, rows) =
    if (not (is_name name)) || List.mem name declared then refuse "shapes: expected a new name, got %S" name;
    let entry v =
      let s = get_name "shapes" v in
      if List.mem s declared then s else refuse "shapes: unknown symbol %s" s
    in
    let rows = List.map (fun row -> List.map entry (get_list name row)) (get_list name rows) in
    if rows = [] || List.hd rows = [] then refuse "shapes: expected rows";
    ignore (make_matrix (List.map (List.map (fun s -> Sym s)) rows));
    (name, rows)
  in
  List.map read (get_object "shapes" value)

let read_rates context value =
  let read (name, rate) =
    let declared_value =
      match List.assoc_opt name context.shapes with
      | Some rows -> Matrix (List.map (List.map (fun s -> Sym s)) rows)
      | None -> if List.mem name context.declared then Scalar (Sym name) else refuse "rates: unknown name %s" name
    in
    match rate with
    | Null -> (name, None)
    | v ->
        let alone = { context with said = []; rates = lazy [] } in
        let rate = read_value_of alone (get_text "rates" v) in
        if alone.branches > 0 then refuse "a rate of cases";
        if shape rate <> shape declared_value then refuse "rates: different shapes";
        (name, Some rate)
  in
  List.map read (get_object "rates" value)

let make_context declared plan shapes rates =
  let shapes = read_shapes declared shapes in
  let rec context =
    { shapes; declared; rates = lazy (read_rates context rates); said = []; given = []; zeros = []; known = []; plan;
      answers = []; quiet = false; branches = 0 }
  in
  ignore (Lazy.force context.rates);
  context
